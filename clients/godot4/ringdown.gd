# Sends what happens in a Godot 4 game to ringdownd, which plays it: OSC over UDP, no add-on.
#
#   const Ringdown = preload("res://ringdown.gd")
#   var ringdown = Ringdown.new()                       # 127.0.0.1, port 7770
#   ringdown.strike("bell", point, impulse)             # in the object's own frame: metres, newton seconds
#
# Godot's axes (right-handed, y up, metres) are those of glTF and of banks baked from glTF files: nothing is converted.
# docs/reference/protocol.md lists all messages.
extends RefCounted

var _socket := PacketPeerUDP.new()


func _init(port := 7770, host := "127.0.0.1") -> void:
	_socket.set_dest_address(host, port)


# Rings the object at the point of its surface nearest to `point`. A contact time of 0.0001 s is steel on steel, 0.001 s a
# rubber mallet. Never waits; without a daemon nothing happens.
func strike(object: String, point: Vector3, impulse: Vector3, contact_time := 0.0002) -> void:
	_send("/object/%s/strike" % object, [point.x, point.y, point.z, impulse.x, impulse.y, impulse.z, contact_time])


# Tells where the object is, for a listener.
func pose(object: String, where: Transform3D) -> void:
	var turn := where.basis.get_rotation_quaternion()
	_send("/object/%s/pose" % object, [where.origin.x, where.origin.y, where.origin.z, turn.w, turn.x, turn.y, turn.z])


# Listens from a camera. Ringdown's listener looks along its x axis, with y to the left and z up.
func listen_from(camera: Transform3D) -> void:
	var axes := Basis(-camera.basis.z, -camera.basis.x, camera.basis.y).orthonormalized()
	var turn := axes.get_rotation_quaternion()
	_send("/listener", [camera.origin.x, camera.origin.y, camera.origin.z, turn.w, turn.x, turn.y, turn.z])


# An OSC message of float32 arguments: address, type tags and arguments, each padded to a multiple of 4 bytes.
func _send(address: String, numbers: Array) -> void:
	var message := StreamPeerBuffer.new()
	message.big_endian = true
	_put_text(message, address)
	var tags := ","
	for _number in numbers:
		tags += "f"
	_put_text(message, tags)
	for number in numbers:
		message.put_float(number)
	_socket.put_packet(message.data_array)


func _put_text(message: StreamPeerBuffer, text: String) -> void:
	var bytes := text.to_ascii_buffer()
	message.put_data(bytes)
	for _i in range(4 - bytes.size() % 4):
		message.put_8(0)
